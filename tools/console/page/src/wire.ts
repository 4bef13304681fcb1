// Messages of the servers, as far as pages use them: proto/tactus/v1 says what
// each field means. Integers of 64 bits are text.

export interface Dataset {
  name: string;
  description: string;
  create_time_ms: string;
  latest_version: number;
  requester: string;
}

export interface DatasetVersion {
  name: string;
  create_time_ms: string;
  trials: number;
  bytes: string;
  labels: Record<string, number>;
  added: number;
  removed: number;
  requester: string;
  change: string;
  reason: string;
  relabelled: number;
  duplicates: number;
  renamed: number;
}

export interface Trial {
  sha256: string;
  id: string;
  label: string;
  condition: string;
  object: string;
  material: string;
  layout: string;
  frames: number;
  source: string;
}

export interface TrainSpec {
  dataset_version: string;
  model: string;
  preset: string;
  note: string;
  seed: string;
}

export interface Progress {
  phase: string;
  fraction: number;
  elapsed_ms: string;
  remaining_ms: string;
}

export interface LearningPoint {
  phase: string;
  part: string;
  iteration: number;
  max_iterations: number;
  log_likelihood?: number | string;
  loss?: number | string;
  accuracy?: number;
  validation_loss?: number | string;
  validation_accuracy?: number;
}

export interface Accuracy {
  correct: number;
  contacts: number;
  low: number;
  high: number;
}

export interface Evaluation {
  accuracy?: Accuracy | null;
  never_felt: number;
  log_loss: number;
  calibration_error: number;
  class_names: string[];
  confusion: number[];
  anytime_s: number[];
  anytime: Accuracy[];
  trained_on_data?: boolean;
  trained_on_contacts: number;
  wrong: { name: string; label: string; answer: string }[];
  // Empty of evaluations that earlier releases made, as `reliability`.
  questions: QuestionReport[];
  reliability: ReliabilityBin[];
}

export interface QuestionReport {
  name: string;
  accuracy?: Accuracy | null;
  anytime: Accuracy[];
}

export interface ReliabilityBin {
  low: number;
  high: number;
  confidence: number;
  accuracy: Accuracy;
}

export interface Comparison {
  current?: Evaluation | null;
  candidate?: Evaluation | null;
  only_current: number;
  only_candidate: number;
  mcnemar_p: number;
  passed: boolean;
  failure: string;
}

export interface PresetChoice {
  preset: string;
  candidates: { preset: string; correct: number; unfit: string }[];
  contacts: number;
}

export interface Operation {
  name: string;
  kind: string;
  state: string;
  create_time_ms: string;
  start_time_ms: string;
  end_time_ms: string;
  attempts: number;
  requester: string;
  // The server's log names it with the job; empty if the requester gave none.
  request_id: string;
  train?: TrainSpec;
  evaluate?: { dataset_version: string; model_version: string;
    protocol: string; train?: TrainSpec | null };
  promote?: { alias: string; model_version: string; force: boolean };
  progress?: Progress | null;
  error?: { message: string; details: { reason?: string }[] } | null;
  result?: { model_version: string; evaluation?: Evaluation | null;
    comparison?: Comparison | null; unusable: number; duplicates: number;
    preset_choice?: PresetChoice | null } | null;
}

export interface ModelVersion {
  name: string;
  bytes: string;
  create_time_ms: string;
  class_names: string[];
  layout_class: string;
  built_in: boolean;
  operation: string;
  train?: TrainSpec | null;
  trials: number;
  duration_ms: string;
  aliases: string[];
  requester: string;
}

export interface Gate {
  dataset_version: string;
  accuracy_margin: number;
  log_loss_margin: number;
  calibration_margin: number;
}

export interface Alias {
  name: string;
  model_version: string;
  etag: string;
  canary?: { model_version: string; per_mille: number } | null;
  gate?: Gate | null;
  previous_version: string;
}

export interface AliasChange {
  model_version: string;
  time_ms: string;
  requester: string;
  forced: boolean;
  rollback: boolean;
}

export interface ServerInfo {
  version?: { version: string; build_type?: string } | null;
  start_time_ms: string;
  time_ms: string;
  uptime_ms: string;
  streams: number;
  max_streams: number;
  data?: { folder: string; blob_bytes: string; upload_bytes: string;
    job_bytes: string; catalog_bytes: string; free_bytes: string } | null;
  jobs: { state: string; count: number }[];
  quotas?: Record<string, string> | null;
  not_served: string[];
  replicas: Replica[];
  caller: string;
}

export interface Replica {
  name: string;
  host: string;
  // Empty for a worker.
  address: string;
  version: string;
  start_time_ms: string;
  is_this: boolean;
  alive: boolean;
  up_to_date: boolean;
}

export interface AuditEntry {
  time_ms: string;
  caller: string;
  peer: string;
  verb: string;
  resource: string;
  reason: string;
}

// Runs exported networks in ONNX Runtime; check.sh runs it.
//
//   node onnxruntime.mjs DIR
//
// DIR holds what `interchange_samples write` made. Runs NAME-sequence.onnx on
// whole sequences and NAME-step.onnx frame by frame, prints the largest
// difference from our posteriors, and writes DIR/onnxruntime.json. Exits with 1
// if a difference is above 1e-5. Needs npm's onnxruntime-node in NODE_PATH.
import fs from 'node:fs';
import {createRequire} from 'node:module';
import path from 'node:path';

const require = createRequire(path.join(process.env.NODE_PATH, 'x.js'));
const ort = require('onnxruntime-node');
const version = require('onnxruntime-node/package.json').version;

const kTolerance = 1e-5;
const folder = process.argv[2];

function tensor(values, dims) {
  return new ort.Tensor('float32', Float32Array.from(values), dims);
}

// Rows of nine digits, which is more than float has.
function rows(values, classes) {
  const out = [];
  for (let i = 0; i < values.length; i += classes) {
    out.push(Array.from(values.slice(i, i + classes), v => +v.toFixed(9)));
  }
  return out;
}

async function runSequence(name, inputs, classes) {
  const session = await ort.InferenceSession.create(
      path.join(folder, `${name}-sequence.onnx`));
  const dims = [inputs.length, 1, inputs[0].length];
  const result = await session.run({input: tensor(inputs.flat(), dims)});
  return rows(result.probability.data, classes);
}

async function runStep(name, inputs, classes) {
  const session =
      await ort.InferenceSession.create(path.join(folder, `${name}-step.onnx`));
  const sizes = stateSizes(path.join(folder, `${name}-step.onnx`), session);
  let state = {};
  for (const [key, size] of Object.entries(sizes)) {
    state[key] = tensor(new Array(size).fill(0), [1, 1, size]);
  }
  const out = [];
  for (const frame of inputs) {
    const input = tensor(frame, [1, 1, frame.length]);
    const result = await session.run({input, ...state});
    out.push(...rows(result.probability.data, classes));
    state = Object.fromEntries(
        Object.keys(sizes).map(key => [key, result[`${key}_next`]]));
  }
  return out;
}

// Cells by the name of each state.
function stateSizes(file, session) {
  const sizes = {};
  for (const [i, name] of session.inputNames.entries()) {
    if (name === 'input') continue;
    sizes[name] = session.inputMetadata[i].shape[2];
  }
  return sizes;
}

function difference(a, b) {
  let worst = a.length === b.length ? 0 : Infinity;
  for (const [t, row] of a.entries()) {
    for (const [k, value] of row.entries()) {
      worst = Math.max(worst, Math.abs(value - b[t][k]));
    }
  }
  return worst;
}

const samples =
    JSON.parse(fs.readFileSync(path.join(folder, 'networks.json'), 'utf8'));
const answers = {};
let worst = 0;
for (const [name, sample] of Object.entries(samples)) {
  const classes = sample.probability[0].length;
  const sequence = await runSequence(name, sample.inputs, classes);
  const step = await runStep(name, sample.inputs, classes);
  const apart = [sequence, step].map(r => difference(r, sample.probability));
  console.log(`${name}: sequence ${apart[0].toExponential(2)}, step ${
      apart[1].toExponential(2)}`);
  worst = Math.max(worst, ...apart);
  answers[name] = {sequence, step};
}
fs.writeFileSync(
    path.join(folder, 'onnxruntime.json'),
    JSON.stringify({peer: `onnxruntime-node ${version}`, answers}) + '\n');
console.log(`onnxruntime-node ${version}: at most ${
    worst.toExponential(2)} (limit ${kTolerance})`);
process.exit(worst <= kTolerance ? 0 : 1);

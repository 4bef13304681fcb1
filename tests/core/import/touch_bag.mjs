// Makes touch.mcap: touch of several types of message of ROS 2, encoded and
// written by other people's packages, so that our reader is not tested against
// our own writer:
//
//   npm install @mcap/core@2.2.2 @foxglove/rosmsg2-serialization@3.1.0 \
//     @foxglove/rosmsg@5.0.5 @foxglove/rosmsg-msgs-common@3.2.3
//   node touch_bag.mjs touch.mcap
import { writeFileSync } from "node:fs";

import rosmsg from "@foxglove/rosmsg";
import common from "@foxglove/rosmsg-msgs-common";
import serialization from "@foxglove/rosmsg2-serialization";
import { McapWriter } from "@mcap/core";

class Memory {
  bytes = [];
  position() {
    return BigInt(this.bytes.length);
  }
  async write(part) {
    for (const byte of part) this.bytes.push(byte);
  }
}

const definitions = common.ros2humble;

// The text of a type and of all that it uses, as rosbag2 stores it.
function schemaOf(type) {
  const parts = [];
  const seen = new Set();
  const add = (name) => {
    if (seen.has(name)) return;
    seen.add(name);
    const definition = definitions[name];
    const typeOf = (f) =>
      f.type === "time" ? "builtin_interfaces/Time" : f.type;
    const lengthOf = (f) => (f.isArray ? `[${f.arrayLength ?? ""}]` : "");
    const lines = definition.definitions.map(
      (f) => `${typeOf(f)}${lengthOf(f)} ${f.name}`,
    );
    parts.push([name, lines.join("\n")]);
    for (const f of definition.definitions) if (f.isComplex) add(f.type);
  };
  add(type);
  return parts
    .map(([name, text], i) =>
      i === 0 ? text : `${"=".repeat(80)}\nMSG: ${name}\n${text}`,
    )
    .join("\n");
}

const memory = new Memory();
const writer = new McapWriter({ writable: memory, useStatistics: true });
await writer.start({ profile: "ros2", library: "@mcap/core, made for a test" });

async function topic(name, type) {
  const text = schemaOf(type);
  const schemaName = type.replace("/", "/msg/");
  const schemaId = await writer.registerSchema({
    name: schemaName,
    encoding: "ros2msg",
    data: new TextEncoder().encode(text),
  });
  const channelId = await writer.registerChannel({
    schemaId,
    topic: name,
    messageEncoding: "cdr",
    metadata: new Map(),
  });
  const coder = new serialization.MessageWriter(
    rosmsg.parse(text, { ros2: true }),
  );
  let sequence = 0;
  return async (time, message) => {
    await writer.addMessage({
      channelId,
      sequence: sequence++,
      logTime: BigInt(time),
      publishTime: BigInt(time),
      data: coder.writeMessage(message),
    });
  };
}

const array = await topic("/touch/array", "std_msgs/Float32MultiArray");
const counts = await topic("/touch/counts", "std_msgs/UInt16MultiArray");
const image = await topic("/touch/image", "sensor_msgs/Image");
const magnet = await topic("/touch/magnet", "sensor_msgs/MagneticField");
const start = 1_700_000_000_000_000_000n;
const dim = (label, size, stride) => ({ label, size, stride });
for (let i = 0; i < 30; ++i) {
  const time = start + BigInt(i) * 20_000_000n;
  const stamp = { sec: 1_700_000_000, nanosec: 20_000_000 * i };
  const header = { stamp, frame_id: "skin" };
  const layout = { dim: [dim("rows", 2, 4), dim("columns", 2, 2)], data_offset: 0 };
  const load = i >= 20 ? 64 + i : 0.5;
  await array(time, { layout, data: Float32Array.of(0.5, load, 0.25, 0.125) });
  await counts(time, { layout: { dim: [], data_offset: 0 }, data: Uint16Array.of(i, 500 + i, 65535) });
  const bytes = new Uint8Array(2 * 3 * 4);
  new DataView(bytes.buffer).setFloat32(4 * 4, load, true);
  await image(time, { header, height: 2, width: 3, encoding: "32FC1", is_bigendian: 0, step: 12, data: bytes });
  await magnet(time, { header, magnetic_field: { x: -1.5, y: i, z: load }, magnetic_field_covariance: new Float64Array(9) });
}
await writer.end();
writeFileSync(process.argv[2], Uint8Array.from(memory.bytes));

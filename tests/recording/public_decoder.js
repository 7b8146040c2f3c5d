// Decodes every message of a recording with the public libraries of MCAP and OMG IDL, by the schema
// in the file, and encodes it again: public_decoder.js FILE, in a folder with node_modules.
//
// Prints of each topic how many messages there are, how many bytes came out as they were, and the
// first that did not. Values that encode to the same bytes are the same to the last bit.
const fs = require("fs");
const path = require("path");
const { createRequire } = require("module");

const use = createRequire(path.join(process.cwd(), "package.json"));
const { McapStreamReader } = use("@mcap/core");
const { parseIDL } = use("@foxglove/omgidl-parser");
const { MessageReader, MessageWriter } = use("@foxglove/omgidl-serialization");
const { EncapsulationKind } = use("@foxglove/cdr");

const reader = new McapStreamReader({ validateCrcs: true });
reader.append(fs.readFileSync(process.argv[2]));
const schemas = new Map();
const channels = new Map();
const coders = new Map();
const topics = {};

function coder(schema) {
  if (!coders.has(schema.id)) {
    const definitions = parseIDL(Buffer.from(schema.data).toString("utf8"));
    coders.set(schema.id, {
      reader: new MessageReader(schema.name, definitions),
      writer: new MessageWriter(schema.name, definitions, { kind: EncapsulationKind.CDR_LE }),
    });
  }
  return coders.get(schema.id);
}

for (let record; (record = reader.nextRecord()); ) {
  if (record.type === "Schema") {
    schemas.set(record.id, record);
  } else if (record.type === "Channel") {
    channels.set(record.id, record);
  } else if (record.type === "Message") {
    const channel = channels.get(record.channelId);
    const { reader: decoder, writer } = coder(schemas.get(channel.schemaId));
    const value = decoder.readMessage(record.data);
    const before = Buffer.from(record.data);
    const after = Buffer.from(writer.writeMessage(value));
    const topic = (topics[channel.topic] ??= { messages: 0, same: 0 });
    topic.messages++;
    if (after.equals(before)) {
      topic.same++;
    } else {
      topic.first ??= [before.length, after.length, before.findIndex((b, i) => b !== after[i])];
    }
  }
}
console.log(JSON.stringify(topics));

"""Decodes every message of a recording by public Python libraries (PyPI mcap and rosbags) with the
schema in the file, and encodes it again: public_decoder.py FILE

Prints, as public_decoder.js, how many messages each topic has, and how many are the same again.
rosbags knows no enumerations: in the schema they are replaced by the integers that they are in CDR.
"""

import collections
import json
import re
import sys

from mcap.reader import make_reader
from rosbags.typesys import Stores, get_types_from_idl, get_typestore

CDR_HEADER_BYTES = 4


def type_store(schema_text):
    enumerations = re.findall(r"\benum\s+(\w+)", schema_text)
    text = re.sub(r"\benum\s+\w+\s*\{[^}]*\}\s*;", "", schema_text)
    for name in enumerations:
        text = re.sub(rf"\b{name}\b", "unsigned long", text)
    store = get_typestore(Stores.EMPTY)
    store.register(get_types_from_idl(text))
    return store


def main():
    stores = {}
    topics = collections.defaultdict(lambda: {"messages": 0, "same": 0})
    with open(sys.argv[1], "rb") as stream:
        messages = make_reader(stream, validate_crcs=True).iter_messages(log_time_order=False)
        for schema, channel, message in messages:
            if schema.id not in stores:
                stores[schema.id] = type_store(schema.data.decode())
            store, name = stores[schema.id], schema.name.replace("::", "/")
            decoded = store.deserialize_cdr(message.data, name)
            encoded = bytes(store.serialize_cdr(decoded, name, little_endian=message.data[1] == 1))
            # The two bytes of options may count padding behind the message.
            known, again = message.data[CDR_HEADER_BYTES:], encoded[CDR_HEADER_BYTES:]
            padding = known[len(again) :]
            is_same = known[: len(again)] == again and len(padding) < 4 and not any(padding)
            topics[channel.topic]["messages"] += 1
            topics[channel.topic]["same"] += is_same
    print(json.dumps(topics))


if __name__ == "__main__":
    main()

"""Streams one second of touch to a Tactus server and prints what it felt."""

import struct
import sys

import grpc
from tactus.v1 import common_pb2, contact_pb2 as pb, contact_pb2_grpc

KIND = pb.ContactEvent.Kind


def requests():
    config = pb.StreamConfig(
        geometry=common_pb2.SensorGeometry(layout="cody-forearm"),
        taxel_type=common_pb2.TAXEL_TYPE_UINT16,
        scale=0.001,  # It counts millinewtons.
    )
    yield pb.ClassifyContactRequest(config=config)
    for t in range(100):
        taxels = [0] * 16 * 24  # Read your skin here.
        for taxel in (180, 181, 204, 205):
            taxels[taxel] = 20 * t
        frames = pb.FrameBatch(
            first_sequence=t + 1,
            first_capture_time_ns=10_000_000 * t,
            frame_count=1,
            taxels=struct.pack("<384H", *taxels),
        )
        yield pb.ClassifyContactRequest(frames=frames)
    yield pb.ClassifyContactRequest(end_of_trial={})


def show(event, answer, questions):
    contact = next(c for c in answer.contacts if c.id == event.contact_id)
    ms = contact.time_since_onset_ns // 10**6
    kind = KIND.Name(event.kind)[len("KIND_") :].lower().replace("_", " ")
    line = f"{ms} ms: contact {contact.id} {kind}"
    if event.kind in (KIND.KIND_DECIDED, KIND.KIND_CHANGED):
        question = questions[event.question]
        line += f" {question.name}: {question.values[event.value]}"
    print(line)  # A robot would react here.


server = sys.argv[1] if len(sys.argv) > 1 else "127.0.0.1:50051"
with grpc.insecure_channel(server) as channel:
    stub = contact_pb2_grpc.ContactServiceStub(channel)
    for response in stub.ClassifyContact(requests(), timeout=10):
        if response.HasField("started"):
            questions = response.started.questions
        answer = response.answer
        for event in answer.events:
            show(event, answer, questions)
        if answer.is_final:
            for q, given in zip(questions, answer.contacts[0].answers):
                for value, p in zip(q.values, given.probability):
                    print(f"{q.name}: {value} {p:.6f}")

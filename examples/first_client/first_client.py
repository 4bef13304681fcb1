"""Streams one second of touch to a Tactus server and prints its answer."""

import struct
import sys

import grpc
from tactus.v1 import common_pb2, contact_pb2, contact_pb2_grpc


def requests():
    yield contact_pb2.ClassifyContactRequest(
        config=contact_pb2.StreamConfig(
            model="models/no-poses",  # "default" needs poses of the arm.
            geometry=common_pb2.SensorGeometry(layout="cody-forearm"),
            taxel_type=common_pb2.TAXEL_TYPE_UINT16,
            scale=0.001,  # The skin counts millinewtons.
        )
    )
    for t in range(100):
        taxels = [0] * 16 * 24  # Read your skin here.
        for taxel in (180, 181, 204, 205):
            taxels[taxel] = 20 * t
        frames = contact_pb2.FrameBatch(
            first_sequence=t + 1,
            first_capture_time_ns=10_000_000 * t,
            frame_count=1,
            taxels=struct.pack("<384H", *taxels),
        )
        yield contact_pb2.ClassifyContactRequest(frames=frames)
    yield contact_pb2.ClassifyContactRequest(end_of_trial={})


server = sys.argv[1] if len(sys.argv) > 1 else "127.0.0.1:50051"
with grpc.insecure_channel(server) as channel:
    stub = contact_pb2_grpc.ContactServiceStub(channel)
    for response in stub.ClassifyContact(requests(), timeout=10):
        if response.HasField("started"):
            names = response.started.class_names
        for event in response.answer.events:  # A robot would react here.
            print(f"event {event.kind}")
        if response.answer.is_final:
            for contact in response.answer.contacts:
                for name, p in zip(names, contact.probability):
                    print(f"{name} {p:.6f}")

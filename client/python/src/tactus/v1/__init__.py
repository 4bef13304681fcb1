"""The messages of proto/tactus/v1, as protoc generates them.

Programs that need only what ``tactus`` exports do not import them.
"""

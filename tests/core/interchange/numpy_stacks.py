"""Classifiers with hidden layers, as Keras lays them out in HDF5 and as ONNX,
with the posteriors that numpy computes; check.sh runs it.

    numpy_stacks.py DIR    writes the files and DIR/stacks.json

Needs python3-numpy and python3-h5py. Everything is seeded. The forward passes
below are written from the documentation of Keras and ONNX and in double
precision; the weights are those of the files, rounded to float.
"""

import json
import os
import struct
import sys

import h5py
import numpy as np

RANDOM = np.random.default_rng(5)
FRAMES = 25


def floats(*shape, scale=1.0):
    values = RANDOM.normal(size=shape) * scale
    return values.astype("f4").astype("f8")


def sequence(inputs):
    return np.cumsum(RANDOM.normal(size=(FRAMES, inputs)), axis=0) * 0.3


def sigmoid(x):
    return 1 / (1 + np.exp(-x))


def relu(x):
    return np.maximum(x, 0)


def softmax(x):
    e = np.exp(x - x.max(axis=-1, keepdims=True))
    return e / e.sum(axis=-1, keepdims=True)


ACTIVATIONS = {
    "relu": relu,
    "tanh": np.tanh,
    "sigmoid": sigmoid,
    "softmax": softmax,
    "linear": lambda x: x,
}


def lstm(x, layer):
    """Keras' layout: gates i, f, c, o."""
    cells = layer["recurrent_kernel"].shape[0]
    h, c = np.zeros(cells), np.zeros(cells)
    out = []
    for row in x:
        z = row @ layer["kernel"] + h @ layer["recurrent_kernel"] + layer["bias"]
        i, f, g, o = np.split(z, 4)
        c = sigmoid(f) * c + sigmoid(i) * np.tanh(g)
        h = sigmoid(o) * np.tanh(c)
        out.append(h)
    return np.array(out)


def normalize(x, layer, epsilon):
    scale = layer.get("gamma", 1) / np.sqrt(layer["moving_variance"] + epsilon)
    return (x - layer["moving_mean"]) * scale + layer.get("beta", 0)


def new_lstm(inputs, cells):
    return {
        "kernel": floats(inputs, 4 * cells),
        "recurrent_kernel": floats(cells, 4 * cells, scale=0.7),
        "bias": floats(4 * cells, scale=0.5),
    }


def new_dense(inputs, units):
    return {"kernel": floats(inputs, units), "bias": floats(units)}


def new_normalization(features, gamma=True, beta=True):
    layer = {}
    if gamma:
        layer["gamma"] = floats(features)
    if beta:
        layer["beta"] = floats(features)
    layer["moving_mean"] = floats(features, scale=0.5)
    layer["moving_variance"] = np.abs(floats(features)) + 0.1
    layer["moving_variance"] = layer["moving_variance"].astype("f4").astype("f8")
    return layer


# Keras. A layer of a model: class, config, weights.


def keras_forward(model, x):
    for kind, config, weights in model:
        if kind == "LSTM":
            x = lstm(x, weights)
        elif kind in ("Dense", "TimeDistributed"):
            inner = config["layer"]["config"] if "layer" in config else config
            x = x @ weights["kernel"] + weights["bias"]
            x = ACTIVATIONS[inner["activation"]](x)
        elif kind == "BatchNormalization":
            x = normalize(x, weights, config["epsilon"])
        elif kind == "Activation":
            x = ACTIVATIONS[config["activation"]](x)
    return x


def write_keras(path, model, version, functional=False, whole=True):
    layers = []
    with h5py.File(path, "w") as file:
        group = file.create_group("model_weights") if whole else file
        names = []
        for kind, config, weights in model:
            layers.append({"class_name": kind, "config": config})
            name = config["name"]
            names.append(name)
            own = group.create_group(name)
            paths = [f"{name}/{key}:0" for key in weights]
            own.attrs["weight_names"] = np.array(paths, dtype="S")
            for key, array in weights.items():
                own[f"{name}/{key}:0"] = array.astype("f4")
        group.attrs["layer_names"] = np.array(names, dtype="S")
        group.attrs["keras_version"] = version
        if not whole:
            return
        config = {"name": "net", "layers": layers}
        if functional:
            config["input_layers"] = [["input", 0, 0]]
            config["output_layers"] = [[names[-1], 0, 0]]
        file.attrs["keras_version"] = version
        file.attrs["model_config"] = json.dumps(
            {
                "class_name": "Functional" if functional else "Sequential",
                "config": config,
            }
        )


def item(kind, name, weights=None, **config):
    return (kind, {"name": name, **config}, weights or {})


def keras_cases(folder):
    answers = []

    def record(name, model, inputs, version, last, **options):
        x = sequence(inputs)
        probability = keras_forward(model, x)
        if probability.shape[1] == 1:
            probability = np.hstack([1 - probability, probability])
        if last:
            probability = probability[-1:]
        write_keras(os.path.join(folder, name), model, version, **options)
        answers.append((name, x, probability))

    deep = [
        item("InputLayer", "input"),
        item(
            "BatchNormalization",
            "norm_in",
            new_normalization(3),
            axis=[2],
            epsilon=1e-3,
            scale=True,
            center=True,
        ),
        item(
            "LSTM",
            "lstm",
            new_lstm(3, 6),
            activation="tanh",
            recurrent_activation="sigmoid",
            return_sequences=True,
        ),
        item("Dropout", "dropout", rate=0.3),
        item(
            "BatchNormalization",
            "norm",
            new_normalization(6),
            axis=[2],
            epsilon=0.01,
            scale=True,
            center=True,
        ),
        item("LSTM", "lstm_1", new_lstm(6, 5), return_sequences=False),
        item("Dense", "dense", new_dense(5, 8), activation="relu"),
        item(
            "BatchNormalization",
            "norm_1",
            new_normalization(8, gamma=False),
            axis=[1],
            epsilon=1e-3,
            scale=False,
            center=True,
        ),
        item("Dropout", "dropout_1", rate=0.5),
        item("Dense", "dense_1", new_dense(8, 4), activation="softmax"),
    ]
    record("stack-keras2.h5", deep, 3, "2.11.0", last=True)
    wide = [
        item("InputLayer", "input"),
        item("Masking", "masking", mask_value=0.0),
        item("LSTM", "lstm", new_lstm(2, 7), return_sequences=True),
        item("Dense", "embed", new_dense(7, 6), activation="linear"),
        item(
            "BatchNormalization",
            "norm",
            new_normalization(6),
            axis=-1,
            epsilon=1e-3,
            scale=True,
            center=True,
        ),
        item("Activation", "act", activation="relu"),
        item(
            "TimeDistributed",
            "each",
            new_dense(6, 5),
            layer={"class_name": "Dense", "config": {"activation": "tanh"}},
        ),
        item("Activation", "again", activation="sigmoid"),
        item("Dense", "out", new_dense(5, 4), activation="linear"),
        item("Activation", "softmax", activation="softmax"),
    ]
    record("stack-keras3.h5", wide, 2, "3.4.1", last=False, functional=True)
    binary = [
        item("LSTM", "lstm", new_lstm(2, 4)),
        item("Dense", "dense", new_dense(4, 3), activation="sigmoid"),
        item("Dense", "dense_1", new_dense(3, 1), activation="sigmoid"),
    ]
    record("stack-sigmoid.h5", binary, 2, "2.11.0", last=True)
    weights = [
        item("LSTM", "lstm", new_lstm(3, 5)),
        item("Dense", "dense", new_dense(5, 6), activation="relu"),
        item("Dense", "dense_1", new_dense(6, 4), activation="softmax"),
    ]
    record("stack-weights.h5", weights, 3, "2.11.0", last=True, whole=False)
    return answers


# ONNX, written as protobuf without its package.


def varint(value):
    out = b""
    while True:
        low, value = value & 0x7F, value >> 7
        out += bytes([low | (0x80 if value else 0)])
        if not value:
            return out


def number(field, value):
    return varint(field << 3) + varint(value & (2**64 - 1))


def text(field, value):
    data = value if isinstance(value, bytes) else value.encode()
    return varint(field << 3 | 2) + varint(len(data)) + data


def attribute(name, value):
    if isinstance(value, int):
        return text(5, text(1, name) + number(3, value) + number(20, 2))
    if isinstance(value, float):
        body = varint(2 << 3 | 5) + struct.pack("<f", value)
        return text(5, text(1, name) + body + number(20, 1))
    body = b"".join(number(8, v) for v in value)
    return text(5, text(1, name) + body + number(20, 7))


def node(kind, inputs, output, **attributes):
    body = b"".join(text(1, i) for i in inputs) + text(2, output)
    body += text(3, output) + text(4, kind)
    return text(1, body + b"".join(attribute(k, v) for k, v in attributes.items()))


def tensor(name, array):
    array = np.asarray(array)
    is_index = array.dtype.kind == "i"
    body = b"".join(number(1, size) for size in array.shape)
    body += number(2, 7 if is_index else 1) + text(8, name)
    body += text(9, array.astype("<i8" if is_index else "<f4").tobytes())
    return text(5, body)


def value_info(field, name):
    return text(field, text(1, name))


def write_onnx(path, nodes, tensors, output, opset):
    graph = b"".join(nodes) + text(2, "net")
    graph += b"".join(tensor(k, v) for k, v in tensors.items())
    graph += value_info(11, "input") + value_info(12, output)
    model = number(1, 7) + text(7, graph) + text(8, number(2, opset))
    with open(path, "wb") as file:
        file.write(model)


def onnx_lstm(layer):
    """Row blocks i, o, f, c."""

    def order(array):
        i, f, c, o = np.split(array, 4, axis=-1)
        return np.concatenate([i, o, f, c], axis=-1)

    bias = order(layer["bias"])
    return {
        "W": order(layer["kernel"]).T[None],
        "R": order(layer["recurrent_kernel"]).T[None],
        "B": np.concatenate([bias, np.zeros_like(bias)])[None],
    }


def normalization_tensors(layer, prefix):
    names = ("gamma", "beta", "moving_mean", "moving_variance")
    return {f"{prefix}{i}": layer[name] for i, name in enumerate(names)}


def onnx_cases(folder):
    answers = []
    first, dense, out = new_lstm(3, 6), new_dense(6, 5), new_dense(5, 4)
    norm = new_normalization(5)
    nodes = [
        node("LSTM", ["input", "W", "R", "B"], "y", hidden_size=6),
        node("Squeeze", ["y", "one"], "rows"),
        node("Gather", ["rows", "last"], "end", axis=0),
        node("Gemm", ["end", "k1", "b1"], "z1"),
        node("Relu", ["z1"], "a1"),
        node("Dropout", ["a1"], "d1"),
        node("BatchNormalization", ["d1", "n0", "n1", "n2", "n3"], "m1", epsilon=1e-3),
        node("Gemm", ["m1", "k2", "b2"], "z2", transB=1),
        node("Softmax", ["z2"], "p", axis=-1),
    ]
    tensors = {
        **onnx_lstm(first),
        "one": np.array([1]),
        "last": np.array(-1),
        "k1": dense["kernel"],
        "b1": dense["bias"],
        **normalization_tensors(norm, "n"),
        "k2": out["kernel"].T,
        "b2": out["bias"],
    }
    name = "stack-last.onnx"
    write_onnx(os.path.join(folder, name), nodes, tensors, "p", 13)
    x = sequence(3)
    h = lstm(x, first)[-1:]
    a = relu(h @ dense["kernel"] + dense["bias"])
    # The epsilon is a float in the file.
    a = normalize(a, norm, float(np.float32(1e-3)))
    answers.append((name, x, softmax(a @ out["kernel"] + out["bias"])))

    first, norm = new_lstm(2, 5), new_normalization(5)
    dense, hidden, out = new_dense(5, 6), new_dense(6, 3), new_dense(3, 4)
    scale, shift = floats(6), floats(6)
    nodes = [
        node("LSTM", ["input", "W", "R", "B"], "y", hidden_size=5),
        node("Squeeze", ["y", "one"], "rows"),
        node("Transpose", ["rows"], "t1", perm=[1, 2, 0]),
        node("BatchNormalization", ["t1", "n0", "n1", "n2", "n3"], "m1", epsilon=0.5),
        node("Transpose", ["m1"], "t2", perm=[2, 0, 1]),
        node("MatMul", ["t2", "k1"], "z1"),
        node("Add", ["b1", "z1"], "s1"),
        node("Tanh", ["s1"], "a1"),
        node("Mul", ["a1", "scale"], "g1"),
        node("Sub", ["g1", "shift"], "g2"),
        node("MatMul", ["g2", "k2"], "z2"),
        node("Add", ["z2", "b2"], "s2"),
        node("Sigmoid", ["s2"], "a2"),
        node("MatMul", ["a2", "k3"], "z3"),
        node("Add", ["z3", "b3"], "logits"),
    ]
    tensors = {
        **onnx_lstm(first),
        "one": np.array([1]),
        **normalization_tensors(norm, "n"),
        "k1": dense["kernel"],
        "b1": dense["bias"],
        "scale": scale,
        "shift": shift,
        "k2": hidden["kernel"],
        "b2": hidden["bias"],
        "k3": out["kernel"],
        "b3": out["bias"],
    }
    name = "stack-sequence.onnx"
    write_onnx(os.path.join(folder, name), nodes, tensors, "logits", 13)
    x = sequence(2)
    a = normalize(lstm(x, first), norm, 0.5)
    a = np.tanh(a @ dense["kernel"] + dense["bias"]) * scale - shift
    a = sigmoid(a @ hidden["kernel"] + hidden["bias"])
    answers.append((name, x, softmax(a @ out["kernel"] + out["bias"])))
    return answers


def main(folder):
    answers = keras_cases(folder) + onnx_cases(folder)
    rows = [
        {
            "file": name,
            "inputs": x.tolist(),
            "probability": [[round(float(v), 9) for v in row] for row in p],
        }
        for name, x, p in answers
    ]
    with open(os.path.join(folder, "stacks.json"), "w") as file:
        json.dump({"peer": f"numpy {np.__version__}", "answers": rows}, file)
        file.write("\n")
    print(f"numpy {np.__version__}: {len(rows)} files")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])

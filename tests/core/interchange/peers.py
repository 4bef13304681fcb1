"""Other programs' side of the interchange tests; check.sh runs it.

    peers.py make DIR    LSTMs of PyTorch as ONNX, and as Keras lays weights out
                         in HDF5, with PyTorch's posteriors in DIR/torch.json
    peers.py hmm DIR     scores the exported HMMs of DIR with pomegranate
    peers.py opencv DIR  runs the exported networks of DIR in OpenCV

Needs Debian's python3-torch, python3-onnx, python3-h5py, python3-pomegranate
and python3-opencv. Everything is seeded. Exits with 1 if a figure is beyond its
tolerance.
"""

import json
import os
import sys

import numpy as np

POSTERIOR_TOLERANCE = 1e-5
LIKELIHOOD_TOLERANCE = 1e-9


def rows(tensor):
    return [[round(float(v), 9) for v in row] for row in tensor]


def fail_above(limit, worst, what):
    print(f"{what}: at most {worst:.3g} (limit {limit:g})")
    if not worst <= limit:
        sys.exit(1)


# PyTorch, as ONNX.


def make_torch_net(torch, inputs, cells, layers, classes, last, batch_first):
    class Net(torch.nn.Module):
        def __init__(self):
            super().__init__()
            self.lstm = torch.nn.LSTM(
                inputs, cells, layers, batch_first=batch_first
            )
            self.dense = torch.nn.Linear(cells, classes)

        def forward(self, x):
            y, _ = self.lstm(x)
            if last:
                y = y[:, -1, :] if batch_first else y[-1]
            return torch.softmax(self.dense(y), -1)

    net = Net().eval()
    with torch.no_grad():
        for parameter in net.parameters():
            parameter.mul_(2.5)
    return net


def torch_cases(torch, folder):
    answers = []
    cases = [
        # layers, last frame alone, batch first, opset
        (1, False, False, 13),
        (2, False, True, 11),
        (2, True, True, 13),
        (3, True, False, 9),
    ]
    for layers, last, batch_first, opset in cases:
        inputs, cells, classes, frames = 3, 6, 4, 25
        net = make_torch_net(
            torch, inputs, cells, layers, classes, last, batch_first
        )
        x = torch.randn(frames, inputs).cumsum(0) * 0.3
        batch = x.unsqueeze(0 if batch_first else 1)
        name = "torch-{}{}-{}-opset{}.onnx".format(
            layers,
            "-last" if last else "",
            "batch-first" if batch_first else "time-first",
            opset,
        )
        torch.onnx.export(
            net,
            batch,
            os.path.join(folder, name),
            opset_version=opset,
            input_names=["input"],
            output_names=["probability"],
            dynamic_axes={"input": {1 if batch_first else 0: "frames"}},
        )
        with torch.no_grad():
            probability = net(batch).reshape(-1, classes)
        answers.append(
            {"file": name, "inputs": x.tolist(), "probability": rows(probability)}
        )
    return answers


# Keras' layout of weights: kernel [I, 4H], recurrent_kernel [H, 4H], bias [4H],
# gates i, f, c, o, which is PyTorch's order too.


def lstm_posteriors(torch, layers, dense, x, activation, gate):
    """Plain cells of torch, for activations that nn.LSTM does not have."""
    sequence = x.double()
    for kernel, recurrent, bias in layers:
        h = torch.zeros(recurrent.shape[0], dtype=torch.float64)
        c = torch.zeros_like(h)
        outputs = []
        for frame in sequence:
            gates = frame @ kernel + h @ recurrent + bias
            i, f, g, o = gates.chunk(4)
            c = gate(f) * c + gate(i) * activation(g)
            h = gate(o) * activation(c)
            outputs.append(h)
        sequence = torch.stack(outputs)
    return torch.softmax(sequence @ dense[0] + dense[1], dim=1)


def random_layers(torch, inputs, cells, classes):
    layers = []
    for count in cells:
        layers.append(
            (
                torch.randn(inputs, 4 * count).double(),
                torch.randn(count, 4 * count).double() * 0.7,
                torch.randn(4 * count).double() * 0.5,
            )
        )
        inputs = count
    dense = (torch.randn(inputs, classes).double(), torch.randn(classes).double())
    return layers, dense


def from_nn_lstm(torch, net):
    """The weights of nn.LSTM and nn.Linear as Keras has them."""
    layers = []
    for i in range(net.lstm.num_layers):
        w = getattr(net.lstm, f"weight_ih_l{i}").detach().double()
        r = getattr(net.lstm, f"weight_hh_l{i}").detach().double()
        b = (
            getattr(net.lstm, f"bias_ih_l{i}") + getattr(net.lstm, f"bias_hh_l{i}")
        ).detach()
        layers.append((w.T, r.T, b.double()))
    dense = net.dense
    return layers, (dense.weight.detach().double().T, dense.bias.detach().double())


def write_named(group, layers, dense):
    """Keras 2: layer_names and weight_names."""
    names = []

    def add(layer, prefix, arrays):
        names.append(layer)
        own = group.create_group(layer)
        paths = [f"{prefix}/{key}:0" for key in arrays]
        own.attrs["weight_names"] = np.array(paths, dtype="S")
        for path, array in zip(paths, arrays.values()):
            own[path] = np.asarray(array, dtype="f4")

    for i, (kernel, recurrent, bias) in enumerate(layers):
        name = "lstm" if i == 0 else f"lstm_{i}"
        add(
            name,
            f"{name}/lstm_cell",
            {"kernel": kernel, "recurrent_kernel": recurrent, "bias": bias},
        )
        dropout = f"dropout_{i}"
        names.append(dropout)
        group.create_group(dropout).attrs["weight_names"] = np.array([], dtype="f8")
    add("dense", "dense", {"kernel": dense[0], "bias": dense[1]})
    group.attrs["layer_names"] = np.array(names, dtype="S")
    group.attrs["backend"] = "tensorflow"
    group.attrs["keras_version"] = "2.11.0"


def write_numbered(file, layers, dense):
    """Keras 3: numbered arrays without names."""
    for i, arrays in enumerate(layers):
        name = "lstm" if i == 0 else f"lstm_{i}"
        vars_ = file.create_group(f"layers/{name}/cell/vars")
        for k, array in enumerate(arrays):
            vars_[str(k)] = np.asarray(array, dtype="f4")
        # Keras makes an empty group for the layer itself too.
        file.create_group(f"layers/{name}/vars")
    vars_ = file.create_group("layers/dense/vars")
    for k, array in enumerate(dense):
        vars_[str(k)] = np.asarray(array, dtype="f4")


def keras_config(cells, activation, gate):
    layers = [{"class_name": "InputLayer", "config": {"name": "input_1"}}]
    for i, count in enumerate(cells):
        layers.append(
            {
                "class_name": "LSTM",
                "config": {
                    "name": "lstm" if i == 0 else f"lstm_{i}",
                    "units": count,
                    "activation": activation,
                    "recurrent_activation": gate,
                    "go_backwards": False,
                    "use_bias": True,
                },
            }
        )
        layers.append({"class_name": "Dropout", "config": {"rate": 0.2}})
    layers.append(
        {
            "class_name": "TimeDistributed",
            "config": {
                "name": "dense",
                "layer": {"class_name": "Dense", "config": {"activation": "softmax"}},
            },
        }
    )
    return json.dumps(
        {"class_name": "Sequential", "config": {"name": "net", "layers": layers}}
    )


def keras_cases(torch, folder):
    import h5py

    answers = []

    def record(name, x, probability):
        answers.append(
            {"file": name, "inputs": x.tolist(), "probability": rows(probability)}
        )

    def sequence(inputs):
        return torch.randn(25, inputs).cumsum(0) * 0.3

    for name in ("keras2-weights.h5", "keras3.weights.h5"):
        net = make_torch_net(torch, 3, 6, 2, 4, False, True)
        layers, dense = from_nn_lstm(torch, net)
        x = sequence(3)
        with torch.no_grad():
            record(name, x, net(x.unsqueeze(0))[0])
        with h5py.File(os.path.join(folder, name), "w") as file:
            if name.startswith("keras2"):
                write_named(file, layers, dense)
            else:
                write_numbered(file, layers, dense)

    name = "keras2-model.h5"
    cells = [5, 7]
    layers, dense = random_layers(torch, 2, cells, 4)
    # What the file keeps.
    layers = [tuple(a.float().double() for a in layer) for layer in layers]
    dense = tuple(a.float().double() for a in dense)
    x = sequence(2)
    record(
        name,
        x,
        lstm_posteriors(
            torch,
            layers,
            dense,
            x,
            torch.nn.functional.softsign,
            lambda v: torch.clamp(0.2 * v + 0.5, 0, 1),
        ),
    )
    with h5py.File(os.path.join(folder, name), "w") as file:
        file.attrs["model_config"] = keras_config(cells, "softsign", "hard_sigmoid")
        file.attrs["keras_version"] = "2.11.0"
        write_named(file.create_group("model_weights"), layers, dense)
    return answers


def make(folder):
    import warnings

    import h5py
    import onnx
    import torch

    warnings.filterwarnings("ignore")
    torch.manual_seed(7)
    torch.set_num_threads(1)
    answers = torch_cases(torch, folder) + keras_cases(torch, folder)
    peer = "torch {}, onnx {}, h5py {}".format(
        torch.__version__, onnx.__version__, h5py.__version__
    )
    with open(os.path.join(folder, "torch.json"), "w") as file:
        json.dump({"peer": peer, "answers": answers}, file)
        file.write("\n")
    print(f"{peer}: {len(answers)} files")


# HMMs.


def load(folder, name):
    with open(os.path.join(folder, name)) as file:
        return json.load(file)


def full_covariances(hmm):
    covars = np.array(hmm["covars_"])
    n, d = np.array(hmm["means_"]).shape
    if hmm["covariance_type"] == "diag":
        return [np.diag(c) for c in covars]
    if hmm["covariance_type"] == "spherical":
        return [np.eye(d) * c for c in covars]
    return list(covars)


def pomegranate_score(hmm, x):
    import pomegranate

    states = [
        pomegranate.MultivariateGaussianDistribution(np.array(m), np.array(c))
        for m, c in zip(np.array(hmm["means_"]), full_covariances(hmm))
    ]
    model = pomegranate.HiddenMarkovModel.from_matrix(
        np.array(hmm["transmat_"]), states, np.array(hmm["startprob_"]), merge="None"
    )
    return model.log_probability(x)


def mixture_score(weights, scores):
    terms = np.log(weights) + np.array(scores)
    return float(np.logaddexp.reduce(terms))


def classes_of_npz(folder):
    """hmms.npz as the JSON file has it."""
    arrays = np.load(os.path.join(folder, "hmms.npz"), allow_pickle=False)
    classes = []
    for i, name in enumerate(arrays["class_names"]):
        weights = arrays[f"{i}/weights"]
        hmms = [
            {
                key: arrays[f"{i}/{k}/{key}"]
                for key in ("startprob_", "transmat_", "means_", "covars_")
            }
            | {"covariance_type": str(arrays[f"{i}/{k}/covariance_type"])}
            for k in range(len(weights))
        ]
        classes.append({"name": str(name), "weights": weights, "hmms": hmms})
    return classes


def classes_of_ghmm(folder):
    """hmms-ghmm.json under hmmlearn's names."""
    classes = load(folder, "hmms-ghmm.json")["classes"]
    for item in classes:
        for hmm in item["hmms"]:
            d = len(hmm["B"][0][0])
            hmm["startprob_"] = hmm["pi"]
            hmm["transmat_"] = hmm["A"]
            hmm["means_"] = [b[0] for b in hmm["B"]]
            hmm["covars_"] = [np.reshape(b[1], (d, d)) for b in hmm["B"]]
            hmm["covariance_type"] = "full"
    return classes


def check_hmms(folder):
    import pomegranate

    sequences = load(folder, "hmm-scores.json")
    kinds = {
        "hmms.json": load(folder, "hmms.json")["classes"],
        "hmms.npz": classes_of_npz(folder),
        "hmms-ghmm.json": classes_of_ghmm(folder),
    }
    recorded = []
    for kind, classes in kinds.items():
        worst = 0
        recorded = []
        for sequence in sequences:
            x = np.array(sequence["observations"])
            scores = [
                mixture_score(
                    item["weights"], [pomegranate_score(h, x) for h in item["hmms"]]
                )
                for item in classes
            ]
            recorded.append(scores)
            ours = np.array(sequence["log_likelihood"])
            worst = max(worst, np.max(np.abs(np.array(scores) / ours - 1)))
        fail_above(LIKELIHOOD_TOLERANCE, worst, f"pomegranate, {kind}, relative")
    with open(os.path.join(folder, "pomegranate.json"), "w") as file:
        json.dump(
            {
                "peer": f"pomegranate {pomegranate.__version__}",
                "log_likelihood": recorded,
            },
            file,
        )
        file.write("\n")


def check_opencv(folder):
    import cv2

    worst = 0
    loaded = []
    for name, sample in load(folder, "networks.json").items():
        # OpenCV's Python takes a last axis of up to four for channels.
        x = np.array(sample["inputs"], dtype="f4")[:, None, :, None]
        path = os.path.join(folder, f"{name}-sequence.onnx")
        try:
            net = cv2.dnn.readNetFromONNX(path)
        except cv2.error:
            print(f"OpenCV {cv2.__version__} does not load {name}")
            continue
        net.setInput(x)
        got = net.forward().reshape(len(x), -1)
        worst = max(worst, np.max(np.abs(got - sample["probability"])))
        loaded.append(name)
    print(f"OpenCV {cv2.__version__} loads {', '.join(loaded)}")
    fail_above(POSTERIOR_TOLERANCE, worst, f"OpenCV {cv2.__version__}, posteriors")


def main():
    verbs = {"make": make, "hmm": check_hmms, "opencv": check_opencv}
    if len(sys.argv) != 3 or sys.argv[1] not in verbs:
        sys.exit(__doc__)
    verbs[sys.argv[1]](sys.argv[2])


if __name__ == "__main__":
    main()

"""Trains LSTM networks in PyTorch, in double precision.

    torch_training.py CASES ANSWERS
    torch_training.py --golden tests/golden/lstm_training.json

CASES is a JSON list of networks, batches and options; ANSWERS becomes a list
of what they give: the loss, its gradient, and the weights after some steps of
the optimizer. --golden makes cases of its own and writes them with their
answers. Exits with 77 if torch is absent.
"""

import json
import sys

try:
    import torch
except ImportError:
    sys.exit(77)

from torch.nn import functional

sys.dont_write_bytecode = True
from torch_reference import ACTIVATIONS, GATES, tensor


class Layer(torch.nn.Module):
    def __init__(self, layer, names):
        super().__init__()
        inputs, self.cells = layer["inputs"], layer["cells"]
        rows = 4 * self.cells
        parameter = torch.nn.Parameter
        self.kernel = parameter(tensor(layer["kernel"], rows, inputs))
        self.recurrent = parameter(
            tensor(layer["recurrent"], rows, self.cells)
        )
        self.bias = parameter(tensor(layer["bias"], rows))
        self.names = names

    def forward(self, sequence):
        h = torch.zeros(1, self.cells, dtype=torch.float64)
        if self.names == ("tanh", "sigmoid"):
            weights = [
                self.kernel,
                self.recurrent,
                self.bias,
                torch.zeros_like(self.bias),
            ]
            start = (h.unsqueeze(0), h.unsqueeze(0))
            return torch.lstm(
                sequence.unsqueeze(1), start, weights, True, 1, 0.0, False,
                False, False,
            )[0].squeeze(1)
        activation, gate = ACTIVATIONS[self.names[0]], GATES[self.names[1]]
        c = h
        outputs = []
        for x in sequence:
            sums = x @ self.kernel.T + h @ self.recurrent.T + self.bias
            i, f, g, o = sums.chunk(4, dim=1)
            c = gate(f) * c + gate(i) * activation(g)
            h = gate(o) * activation(c)
            outputs.append(h)
        return torch.cat(outputs)


class Network(torch.nn.Module):
    def __init__(self, network):
        super().__init__()
        names = network["activation"], network["gate_activation"]
        self.layers = torch.nn.ModuleList(
            Layer(layer, names) for layer in network["layers"]
        )
        self.regressions = network["regressions"]
        bias = tensor(network["dense_bias"], -1)
        self.dense_bias = torch.nn.Parameter(bias)
        self.dense_kernel = torch.nn.Parameter(
            tensor(network["dense_kernel"], len(bias), -1)
        )

    def forward(self, sequence):
        for layer in self.layers:
            sequence = layer(sequence)
        return sequence @ self.dense_kernel.T + self.dense_bias

    def tensors(self):
        """In the order of the C++ tests."""
        for layer in self.layers:
            yield from (layer.kernel, layer.recurrent, layer.bias)
        yield from (self.dense_kernel, self.dense_bias)


def sequence_loss(network, sequence, options):
    inputs = network.layers[0].kernel.shape[1]
    outputs = network(tensor(sequence["inputs"], -1, inputs))
    steps = [len(outputs) - 1]
    if options["every_step"]:
        first, stride = options["first_step"], options["stride"]
        steps = list(range(first, steps[0], stride)) + steps
    outputs = outputs[steps]
    r = network.regressions
    classes = outputs.shape[1] - 2 * r
    label = torch.full((len(steps),), sequence["label"])
    loss = functional.cross_entropy(
        outputs[:, :classes], label, label_smoothing=options["label_smoothing"]
    )
    if sequence["targets"]:
        targets = tensor(sequence["targets"], -1, r)[steps]
        mean, log_variance = outputs[:, classes:].chunk(2, dim=1)
        each = functional.gaussian_nll_loss(
            mean, targets, log_variance.exp(), eps=1e-30, reduction="none"
        )
        loss = loss + options["regression_weight"] * each.sum(dim=1).mean()
    return sequence["weight"] * loss


def batch_loss(network, case):
    losses = [
        sequence_loss(network, sequence, case["loss"])
        for sequence in case["batch"]
    ]
    return sum(losses) / len(losses)


def make_optimizer(network, options):
    kernels = [p for p in network.tensors() if p.dim() == 2]
    biases = [p for p in network.tensors() if p.dim() == 1]
    groups = [
        {"params": kernels, "weight_decay": options["weight_decay"]},
        {"params": biases, "weight_decay": 0.0},
    ]
    rate = options["learning_rate"]
    if options["name"] == "adam":
        return torch.optim.AdamW(groups, lr=rate, eps=1e-7)
    return torch.optim.RMSprop(groups, lr=rate, alpha=0.9, eps=1e-7)


def run(case):
    network = Network(case["network"])
    loss = batch_loss(network, case)
    loss.backward()
    gradient = [p.grad.flatten().tolist() for p in network.tensors()]
    options = case["optimizer"]
    optimizer = make_optimizer(network, options)
    for _ in range(options["steps"]):
        optimizer.zero_grad()
        batch_loss(network, case).backward()
        if options["gradient_clip"] > 0:
            torch.nn.utils.clip_grad_norm_(
                list(network.tensors()), options["gradient_clip"]
            )
        optimizer.step()
    return {
        "loss": loss.item(),
        "gradient": gradient,
        "trained": [p.flatten().tolist() for p in network.tensors()],
    }


def rounded(size, *shape):
    """Multiples of 1/256: few digits, and float holds them exactly."""
    values = torch.round(torch.randn(*shape) * size * 256) / 256
    return values.flatten().tolist()


def golden_case(names, every_step, optimizer):
    inputs, classes, regressions = 3, 3, 2
    layers = []
    width = inputs
    for cells in (3, 4):
        layers.append(
            {
                "inputs": width,
                "cells": cells,
                "kernel": rounded(0.7, 4 * cells, width),
                "recurrent": rounded(0.7, 4 * cells, cells),
                "bias": rounded(0.5, 4 * cells),
            }
        )
        width = cells
    outputs = classes + 2 * regressions
    batch = []
    for i, steps in enumerate((5, 8, 1)):
        batch.append(
            {
                "inputs": rounded(1.0, steps, inputs),
                "label": i,
                "targets": rounded(1.0, steps, regressions) if i else [],
                "weight": 0.5 + i,
            }
        )
    return {
        "network": {
            "activation": names[0],
            "gate_activation": names[1],
            "layers": layers,
            "regressions": regressions,
            "dense_kernel": rounded(0.7, outputs, width),
            "dense_bias": rounded(0.5, outputs),
        },
        "batch": batch,
        "loss": {
            "every_step": every_step,
            "first_step": 1,
            "stride": 2,
            "label_smoothing": 0.1,
            "regression_weight": 0.5,
        },
        "optimizer": optimizer,
    }


def golden():
    torch.manual_seed(1)
    adam = {
        "name": "adam",
        "learning_rate": 0.01,
        "weight_decay": 0.1,
        "gradient_clip": 0.5,
        "steps": 5,
    }
    rmsprop = dict(
        adam, name="rmsprop", weight_decay=0.0, gradient_clip=0.0
    )
    cases = [
        golden_case((activation, gate), gate == "sigmoid", optimizer)
        for activation, optimizer in (("tanh", adam), ("softsign", rmsprop))
        for gate in GATES
    ]
    for case in cases:
        answer = run(case)
        for name in ("gradient", "trained"):
            answer[name] = [
                [float(f"{x:.8g}") for x in row] for row in answer[name]
            ]
        case["answer"] = answer
    command = "python3 tests/core/lstm/torch_training.py --golden"
    return {
        "made_by": f"{command} tests/golden/lstm_training.json",
        "pytorch": torch.__version__,
        "cases": cases,
    }


def main():
    torch.set_num_threads(1)
    if sys.argv[1] == "--golden":
        result = golden()
    else:
        with open(sys.argv[1]) as file:
            result = [run(case) for case in json.load(file)]
    with open(sys.argv[2], "w") as file:
        json.dump(result, file)
        file.write("\n")


if __name__ == "__main__":
    main()

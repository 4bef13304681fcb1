"""Runs LSTM networks in PyTorch, in double precision.

    torch_reference.py CASES ANSWERS

CASES is a JSON list of {"network": ..., "inputs": [T][I]}; ANSWERS becomes the
list of probabilities, [T][classes] each. Exits with 77 if torch is absent.
"""

import json
import sys

try:
    import torch
except ImportError:
    sys.exit(77)

ACTIVATIONS = {"tanh": torch.tanh, "softsign": torch.nn.functional.softsign}
GATES = {
    "sigmoid": torch.sigmoid,
    "hard_sigmoid": lambda x: torch.clamp(0.2 * x + 0.5, 0, 1),
}


def tensor(values, *shape):
    return torch.tensor(values, dtype=torch.float64).reshape(shape)


def weights(layer):
    inputs, cells = layer["inputs"], layer["cells"]
    return (
        tensor(layer["kernel"], 4 * cells, inputs),
        tensor(layer["recurrent"], 4 * cells, cells),
        tensor(layer["bias"], 4 * cells),
    )


def torch_layer(layer, sequence):
    """nn.LSTM: tanh and sigmoid; its gates come in our order too."""
    lstm = torch.nn.LSTM(layer["inputs"], layer["cells"], dtype=torch.float64)
    kernel, recurrent, bias = weights(layer)
    with torch.no_grad():
        lstm.weight_ih_l0.copy_(kernel)
        lstm.weight_hh_l0.copy_(recurrent)
        lstm.bias_ih_l0.copy_(bias)
        lstm.bias_hh_l0.zero_()
        return lstm(sequence.unsqueeze(1))[0].squeeze(1)


def manual_layer(layer, sequence, activation, gate):
    kernel, recurrent, bias = weights(layer)
    h = torch.zeros(layer["cells"], dtype=torch.float64)
    c = torch.zeros_like(h)
    outputs = []
    for x in sequence:
        i, f, g, o = (kernel @ x + recurrent @ h + bias).chunk(4)
        c = gate(f) * c + gate(i) * activation(g)
        h = gate(o) * activation(c)
        outputs.append(h)
    return torch.stack(outputs)


def run(case):
    network = case["network"]
    names = network["activation"], network["gate_activation"]
    inputs = network["layers"][0]["inputs"]
    sequence = tensor(case["inputs"], -1, inputs)
    for layer in network["layers"]:
        if names == ("tanh", "sigmoid"):
            sequence = torch_layer(layer, sequence)
        else:
            sequence = manual_layer(
                layer, sequence, ACTIVATIONS[names[0]], GATES[names[1]]
            )
    bias = tensor(network["dense_bias"], -1)
    kernel = tensor(network["dense_kernel"], len(bias), -1)
    return torch.softmax(sequence @ kernel.T + bias, dim=1).tolist()


def main():
    torch.set_num_threads(1)
    with open(sys.argv[1]) as file:
        cases = json.load(file)
    with open(sys.argv[2], "w") as file:
        json.dump([run(case) for case in cases], file)


if __name__ == "__main__":
    main()

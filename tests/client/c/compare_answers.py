"""Compares two outputs of c_answers: prints the differences as one line.

    compare_answers.py HERE THERE LIMIT

Fails if an event differs, a line is missing, or a number by more than LIMIT.
"""
import sys


def main():
    here, there = (open(path).read().splitlines() for path in sys.argv[1:3])
    limit = float(sys.argv[3])
    trials = equal_lines = equal_trials = numbers = equal_numbers = 0
    largest = 0.0
    same_trial = True
    faults = []
    if len(here) != len(there):
        faults.append(f"{len(here)} lines here, {len(there)} there")
    for number, (a, b) in enumerate(zip(here, there), 1):
        if a.startswith("trial"):
            equal_trials += trials > 0 and same_trial
            trials += 1
            same_trial = True
        equal_lines += a == b
        same_trial = same_trial and a == b
        (kind_a, *left), (kind_b, *right) = a.split(), b.split()
        if kind_a != kind_b or len(left) != len(right):
            faults.append(f"line {number}: {a} / {b}")
            continue
        if kind_a == "event" and a != b:
            faults.append(f"line {number}: {a} / {b}")
        if kind_a != "contact":
            continue
        numbers += len(left)
        equal_numbers += sum(x == y for x, y in zip(left, right))
        largest = max([largest] + [abs(float(x) - float(y))
                                   for x, y in zip(left, right)])
    equal_trials += trials > 0 and same_trial
    if largest > limit:
        faults.append(f"a number differs by {largest:.3g}, above {limit:g}")
    print(f"{trials} contacts, {equal_trials} of them equal bit for bit; "
          f"{equal_numbers} of {numbers} numbers equal; "
          f"largest difference {largest:.2g}; "
          f"{'all events equal' if not faults else 'FAILED'}")
    for fault in faults[:10]:
        print(fault)
    return 1 if faults or trials == 0 else 0


sys.exit(main())

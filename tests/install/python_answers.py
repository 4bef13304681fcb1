"""Streams a recording to a server, and the same frames to a model in this
process. All answers must have the same bits.

    python_answers.py ADDRESS RECORDING.h5 MODEL.tactus

The model is the one that the server calls default.
"""

import sys

import tactus


def answers_of(stream, trial):
    """What a stream answers to each frame of a trial, and at its end."""
    answers = []
    for frame, pose in zip(trial.taxels, trial.poses):
        answers += stream.push(frame, pose=pose)
    return answers + [stream.end_trial()]


def main():
    address, path, bundle = sys.argv[1:]
    classifier = tactus.Classifier(bundle)
    recording = tactus.Recording(path)
    skin = recording[0].skin
    count = 0
    best = set()
    with tactus.Client(address) as client, client.stream(skin, model="default") as remote, \
            classifier.stream(skin) as local:
        if remote.info.model_sha256 != classifier.sha256:
            sys.exit("the server's default is another model")
        for i, trial in enumerate(recording):
            theirs, ours = answers_of(remote, trial), answers_of(local, trial)
            if len(ours) != len(trial.taxels) + 1:
                sys.exit(f"trial {i}: {len(ours)} answers to {len(trial.taxels)} frames")
            # Decimals from which a double comes out with the same bits.
            if repr(ours) != repr(theirs):
                sys.exit(f"trial {i}: the answers differ")
            count += len(ours)
            # Some of a simulation's contacts are never felt.
            if ours[-1].main is not None:
                best.add(ours[-1].main.best)
    if len(best) < 2:
        sys.exit(f"every contact is {best}")
    print(f"{len(recording)} contacts, {count} answers with the same bits, {len(best)} classes")


if __name__ == "__main__":
    main()

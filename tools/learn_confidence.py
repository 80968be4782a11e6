#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fits the general weights of confidence (library/confidence_model.cpp) to simulated reports of several libraries.

    for LIB in a b c; do ostraka calibrate $LIB.ostraka --scenes 72 --seed 1001 --examples $LIB.csv; done
    learn_confidence.py a.csv b.csv c.csv

Files of one library may be joined by commas (a1.csv,a2.csv). Prints the weights; the typical values of right
reports (explanation_words.cpp); and for each library what weights learned from the others do on it. Needs numpy.
"""
import argparse
import csv

import numpy

PRIOR = 1.0  # precision of each standardized weight: what few examples show doesn't count
THRESHOLD = 0.94  # the default of --min-confidence


def read(paths):
    numbers = []
    for path in paths.split(","):
        with open(path, newline="", encoding="ascii") as file:
            rows = list(csv.reader(file))
        numbers.append(numpy.array(rows[1:], dtype=float))
    numbers = numpy.vstack(numbers)
    return rows[0][:-1], numbers[:, :-1], numbers[:, -1]


def fit(features, right, given, center, hold):
    """Newton's method on the logistic loss; the first feature is the constant and has no prior. Each weight is
    held to `center` in units of its feature's spread, by `hold` where that is not zero; what is not NaN in `given`
    is not fitted."""
    fixed = ~numpy.isnan(given)
    weights = numpy.where(fixed, given, center)
    prior = numpy.where(center == 0.0, PRIOR, hold)
    if not fixed.all():
        weights[~fixed] += fit_others(features[:, ~fixed], right, features @ weights, prior[~fixed])
    return weights


def fit_others(features, right, offset, prior):
    spread = features.std(axis=0)
    spread[0] = 1.0
    spread[spread == 0.0] = 1.0
    x = features / spread
    prior[0] = 1e-6
    weights = numpy.zeros(x.shape[1])
    for _ in range(200):
        p = probability(weights, x, offset)
        slope = x.T @ (right - p) - prior * weights
        curvature = (x * (p * (1.0 - p))[:, None]).T @ x + numpy.diag(prior)
        step = numpy.linalg.solve(curvature, slope)
        weights += step * min(1.0, 5.0 / max(abs(step).max(), 1e-300))
        if abs(step).max() < 1e-9:
            break
    return weights / spread


def probability(weights, features, offset=0.0):
    return 1.0 / (1.0 + numpy.exp(-numpy.clip(features @ weights + offset, -30.0, 30.0)))


def show(name, p, right):
    loss = -numpy.log(numpy.where(right > 0.5, p, 1.0 - p)).mean()
    sure = p >= THRESHOLD
    print(f"{name:24s} {len(p):6d} reports, {int(right.sum()):6d} right; log loss {loss:.4f}; from {THRESHOLD}: "
          f"{int((sure & (right < 0.5)).sum()):4d} wrong, {int((~sure & (right > 0.5)).sum()):4d} right ones missed")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("csv", nargs="+")
    parser.add_argument("--without", action="append", default=[], help="feature that gets no weight")
    parser.add_argument("--fix", action="append", default=[], metavar="FEATURE=WEIGHT", help="not fitted")
    parser.add_argument("--center", help="weights, separated by commas, that few examples leave as they are "
                        "(default: zero)")
    parser.add_argument("--hold", type=float, default=PRIOR, help="how strongly those of --center that are not zero "
                        "hold: about as the reports that they came from count")
    parser.add_argument("--weights", help="show what these do instead: numbers separated by commas")
    options = parser.parse_args()
    sets = [read(path) for path in options.csv]
    names = sets[0][0]
    fixed = dict(item.split("=") for item in options.fix) | dict.fromkeys(options.without, 0.0)
    given = numpy.array([float(fixed.get(name, "nan")) for name in names])
    if options.weights:
        given = numpy.array(options.weights.split(","), dtype=float)
    center = numpy.array(options.center.split(","), dtype=float) if options.center else numpy.zeros(len(names))
    data = [(features, right) for _, features, right in sets]
    for i, (features, right) in enumerate(data):
        others = [d for k, d in enumerate(data) if k != i] or data
        weights = fit(numpy.vstack([f for f, _ in others]), numpy.hstack([r for _, r in others]),
                      given, center, options.hold)
        show(options.csv[i], probability(weights, features), right)
    features = numpy.vstack([f for f, _ in data])
    right = numpy.hstack([r for _, r in data])
    weights = fit(features, right, given, center, options.hold)
    show("all", probability(weights, features), right)
    print("\nfeature      weight  typical of right reports")
    for k, name in enumerate(names):
        print(f"{name:10s} {weights[k]:8.2f}  {numpy.median(features[right > 0.5, k]):8.3f}")


if __name__ == "__main__":
    main()

#!/usr/bin/env bash
# "Matern, nu = 1/2, length 1" is another field in GSTools than in scikit-learn, and in GSTools itself another one than "Exponential, length 1".
#
# gstools 1.7.0, Matern: 2^(1-nu)/Gamma(nu) z^nu K_nu(z) with z = sqrt(nu) r/len_scale.
# scikit-learn 1.9.1, Matern: the same with z = sqrt(2 nu) r/length_scale, as in textbooks of Gaussian processes.
# So the lengths are in the ratio sqrt(2) for every nu: with nu = 1/2 GSTools has exp(-r/(sqrt(2) len_scale)) where its own Exponential and scikit-learn have
# exp(-r/length). A correlation length that was fitted to measurements with one and put into the other is wrong by 41 %.
# Of the operator 1 - L^2 laplace with white noise (plane: nu = 1, r/L K_1(r/L); space: nu = 1/2, exp(-r/L)): L = len_scale in the plane and sqrt(2) len_scale in
# space of GSTools, L = length_scale/sqrt(2) in the plane and length_scale in space of scikit-learn.
#
# Seen:  correlation at r = 1: gstools nu 1/2 0.4931, nu 1 0.6019; scikit-learn nu 1/2 0.3679, nu 1 0.4443; gstools Exponential 0.3679
set -euo pipefail
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
python3 -m venv "$place/python"
"$place/python/bin/pip" install --quiet --disable-pip-version-check \
    gstools==1.7.0 numpy==2.4.6 scikit-learn==1.9.1 scipy==1.17.1
"$place/python/bin/python" -W ignore - <<'END'
import sys

import gstools
import numpy as np
from scipy.special import kv
from sklearn.gaussian_process.kernels import Matern

r = np.array([0.5, 1.0, 2.0])


def by_gstools(nu, length=1.0):
    return gstools.Matern(dim=3, nu=nu, len_scale=length).correlation(r)


def by_scikit_learn(nu, length=1.0):
    return Matern(length_scale=length, nu=nu)(np.zeros((1, 1)), r[:, None])[0]


exponential = gstools.Exponential(dim=3, len_scale=1.0).correlation(r)
wrong = []


def seen(what, found, expected):
    print(f"{what}: {np.array2string(np.asarray(found), precision=4)}")
    if not np.allclose(found, expected, rtol=1e-6):
        wrong.append(f"{what}: {found}, expected {expected}")


seen("gstools, Exponential", exponential, np.exp(-r))
seen("scikit-learn, nu 1/2", by_scikit_learn(0.5), np.exp(-r))
seen("gstools, nu 1/2", by_gstools(0.5), np.exp(-r / np.sqrt(2)))
seen("gstools, nu 1", by_gstools(1.0), r * kv(1, r))
seen("scikit-learn, nu 1", by_scikit_learn(1.0), np.sqrt(2) * r * kv(1, np.sqrt(2) * r))
for nu in (0.5, 1.0, 1.5):
    seen(f"scikit-learn with sqrt(2) of the length, nu {nu}", by_scikit_learn(nu, np.sqrt(2)), by_gstools(nu))
if wrong:
    sys.exit("changed: " + "; ".join(wrong))
END

#!/usr/bin/env bash
# "mu" and "alpha" of Ogden's law are other materials in sfepy than in felupe and matadi; with a change of volume sfepy's is another law.
#
# felupe 11.3.0, matadi 0.5.0: each term is 2 mu/alpha^2 (l1^alpha + l2^alpha + l3^alpha - 3), as in Abaqus; the shear modulus is sum mu.
# sfepy 2026.3, dw_tl_he_ogden: mu/alpha (..), as in Ogden's papers; the shear modulus is 1/2 sum mu alpha. The same two numbers give stresses in the
# ratio alpha/2: of felupe's example (mu 1 and 0.2, alpha 1.7 and -1.5) 0.70 instead of 1.20, the second term with the wrong sign.
# With mu_sfepy = 2 mu/alpha both agree at constant volume, but sfepy scales by J^(-2/3) for every alpha, where the isochoric law
# (l_i of J^(-1/3) F, as in felupe and matadi) has J^(-alpha/3): its stress is J^((alpha-2)/3) times theirs, equal for alpha = 2 alone.
# Of nearly incompressible bodies that is little (alpha = 4, J = 1.01: 0.7 %), of foams it is not.
#
# Seen:  stress of a stretch by 1.5 at constant volume: felupe, matadi 1.151, sfepy 0.748; with 2 mu/alpha 1.151
#        a third of the secant modulus at a stretch of 1.01: felupe, matadi 1.19, sfepy 0.69
#        a term alpha = 4 at J = 1.215: sfepy 1.139 times felupe and matadi
set -euo pipefail
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
python3 -m venv "$place/python"
"$place/python/bin/pip" install --quiet --disable-pip-version-check \
    felupe==11.3.0 matadi==0.5.0 numpy==2.2.6 sfepy==2026.3 tensortrax==0.29.0
cd "$place"
python/bin/python -W ignore - <<'END'
import sys

import felupe.constitution.tensortrax as by_tensortrax
import matadi
import numpy as np
from felupe.constitution.tensortrax.models.hyperelastic import ogden
from sfepy.base.base import output
from sfepy.discrete import Equation, Equations, FieldVariable, Integral, Material, Problem
from sfepy.discrete.fem import FEDomain, Field
from sfepy.mesh.mesh_generators import gen_block_mesh
from sfepy.terms import Term

output.set_output(quiet=True)


def pull(first, stretches):
    """Nominal stress along the first axis, less the pressure that frees the sides."""
    return float(first[0, 0] - first[1, 1] * stretches[1] / stretches[0])


def by_felupe(terms, stretches):
    law = by_tensortrax.Hyperelastic(ogden, mu=[mu for mu, _ in terms], alpha=[alpha for _, alpha in terms])
    return pull(law.gradient([np.diag(stretches).reshape(3, 3, 1, 1), None])[0][..., 0, 0], stretches)


def by_matadi(terms, stretches):
    numbers = dict(mu=[mu for mu, _ in terms], alpha=[alpha for _, alpha in terms], bulk=0)
    law = matadi.MaterialHyperelastic(matadi.models.ogden, **numbers)
    return pull(law.gradient([np.diag(stretches).reshape(3, 3, 1, 1)])[0][..., 0, 0], stretches)


def by_sfepy(terms, stretches):
    """One cell, stretched alike everywhere; the second stress tensors of the terms add up."""
    mesh = gen_block_mesh([1, 1, 1], [2, 2, 2], [0.5, 0.5, 0.5], verbose=False)
    body = FEDomain("domain", mesh).create_region("Omega", "all")
    field = Field.from_args("displacement", np.float64, "vector", body, approx_order=1)
    u = FieldVariable("u", "unknown", field)
    v = FieldVariable("v", "test", field, primary_var_name="u")
    u.set_data((mesh.coors * (np.array(stretches) - 1)).ravel())
    second = np.zeros(3)
    for mu, alpha in terms:
        term = Term.new("dw_tl_he_ogden(m.p, v, u)", Integral("i", order=2), body,
                        m=Material("m", values={"p": np.array([[mu, alpha]])}), u=u, v=v)
        term.setup()
        Problem("one", equations=Equations([Equation("balance", term)])).update_materials()
        second += term.evaluate(mode="el_avg", term_mode="stress").ravel()[:3]
    return pull(np.diag(stretches) @ np.diag(second), stretches)


terms, same_law = [(1, 1.7), (0.2, -1.5)], [(2 * 1 / 1.7, 1.7), (2 * 0.2 / -1.5, -1.5)]
isochoric, swollen, slight = (1.5, 1.5**-0.5, 1.5**-0.5), (1.5, 0.9, 0.9), (1.01, 1.01**-0.5, 1.01**-0.5)
moduli = [law(terms, slight) / 0.03 for law in (by_felupe, by_matadi, by_sfepy)]
print("third of the secant modulus at a stretch of 1.01 by felupe, matadi, sfepy:", *np.round(moduli, 3))
pulls = [law(terms, isochoric) for law in (by_felupe, by_matadi, by_sfepy)] + [by_sfepy(same_law, isochoric)]
print("stretch by 1.5, felupe, matadi, sfepy, sfepy with 2 mu/alpha:", *np.round(pulls, 4))
fourth = [by_felupe([(1, 4)], swollen), by_matadi([(1, 4)], swollen), by_sfepy([(0.5, 4)], swollen)]
print("alpha = 4 at J = 1.215, felupe, matadi, sfepy with 2 mu/alpha:", *np.round(fourth, 4), "ratio", round(fourth[2] / fourth[0], 4))
exact = lambda factors, stretch: sum(c * (stretch ** (a - 1) - stretch ** (-a / 2 - 1)) for c, a in factors)
expected = [exact(factors, 1.01) / 0.03 for factors in (same_law, same_law, terms)]
expected += [exact(factors, 1.5) for factors in (same_law, same_law, terms, same_law)] + [1, 1.215 ** (2 / 3)]
seen = moduli + pulls + [fourth[1] / fourth[0], fourth[2] / fourth[0]]
if not np.allclose(seen, expected, rtol=5e-3):
    sys.exit("one of them behaves otherwise now")
END

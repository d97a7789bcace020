"""T-splines: specimens get T-meshes of them (`iga.specimen.tmesh_strip`, `iga.tsplines`)."""

from __future__ import annotations

from dataclasses import replace

from iga.bases.nurbs import NURBS

#: Without T-junctions they are the B-splines of the same lines.
TSPLINE = replace(
    NURBS,
    name="tspline",
    label="T-spline",
    what="isogeometric, T-splines",
    degrees=(3,),
    local=True,
    in_a_zone=4.0 / 3.0,
    in_fading=2.0,  # that of the elements through a body, which are twice as long as those at the bond
    coarsest={3: 2.0},
    colours=("#4b3fa0", "#b0a5ff"),
    place=0,
    row=2,
)

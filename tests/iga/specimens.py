"""The specimen of the paper (Dimitri, De Lorenzis, Zavarise 2013), first law, on a mesh for tests."""

from iga.dcb import Problem

E, NU = 120e3, 0.2
PAPER = Problem(
    length=14.0,
    arm_thickness=0.2,
    precrack=4.0,
    E1=E,
    E2=E,
    G12=E / (2 * (1 + NU)),
    nu12=NU,
    strength=4.0,
    toughness=0.1,
    ductility=12.5,
    penalty=1e5,
    opening=(1.0,),
    dofs=280,
)

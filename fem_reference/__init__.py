"""DOLFINx model of a debonding interface; the only place that imports DOLFINx."""

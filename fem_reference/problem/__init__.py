"""Problems in plain numbers, free of DOLFINx."""

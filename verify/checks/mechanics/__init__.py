"""Identities in the columns of one run: the J-integral, crack growth in a peel, tolerances of force balances."""

"""What the columns of one run must obey: the J-integral, the growth of a peel, balances of forces."""

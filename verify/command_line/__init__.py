"""What the command line offers besides work: scenes to look at and to start from, completion of words."""

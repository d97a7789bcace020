"""The bond of a scene: its table of keys, the corners of a tabular law, and the law for opening and sliding."""

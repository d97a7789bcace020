"""Facts of a mesh file and its picture: `debond mesh`."""

"""One file a basis, each of which makes a mesh."""

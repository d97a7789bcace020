"""Meshes of users in files of other programs, held against the specimen of a scene."""

"""Fields for ParaView and their moments."""

"""The displacement paths on which a law is judged."""

"""What is known of a scene in addition to its problem: published and certified values, and uncertainties."""

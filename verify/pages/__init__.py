"""Common parts of all pages: style, figures, templates, texts."""

"""What a value may be, wherever it stands: strict classes, and what a plain YAML scalar means."""

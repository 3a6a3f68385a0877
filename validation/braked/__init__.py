"""The braked wheel: 3D-RFT on its rim by plain quadrature, and candidates for what it lacks."""

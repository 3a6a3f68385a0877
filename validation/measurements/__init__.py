"""Models against measured sand: plates and a wheel of Carnegie Mellon, a dropped ball, a dragged plate."""

"""Measurements in sand and models of them: plates and a wheel of Carnegie Mellon, a dropped ball, a dragged plate."""

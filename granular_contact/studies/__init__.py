"""Many runs for one answer: compared, swept, fitted."""

"""What is measured on sampled steps, beside the stress that every step is measured for."""

"""Vibration about equilibria: modes, frequency responses, Campbell diagrams."""

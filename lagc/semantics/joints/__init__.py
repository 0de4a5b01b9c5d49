"""Joints: the table of kinds, the places of the bodies that they tie, and their equations."""

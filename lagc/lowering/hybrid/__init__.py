"""Event indicators and step guards."""

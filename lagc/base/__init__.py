"""What every room may use: records, and text of people and for terminals."""

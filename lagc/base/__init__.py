"""What every room may use: records, values computed once, printable text, numerals."""

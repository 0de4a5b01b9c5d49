"""The language of kernels: words, sizes, tables, records, statuses."""

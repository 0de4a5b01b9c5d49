"""Names: namespaces, scopes, modifications, data files, effects."""

"""Analysis of the constraints: mobility and integrability."""

"""Functional Mock-up Units: FMI 3.0 and 2.0 (Modelica Association Project FMI, https://fmi-standard.org)."""

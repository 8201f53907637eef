"""Blind data sets of machines that the product has never seen: made, diagnosed and scored. Shares no code with the product."""

"""Robots that are far from each other, stepped in plants of their own."""

"""Controllers at mid-block crossings, on the same seeds: ``make study-crossings``."""

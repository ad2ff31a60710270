"""What is written of a run: tables, the description of the run and the folder that they go to."""

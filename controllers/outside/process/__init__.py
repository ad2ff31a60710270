"""Controllers that are programs of their own: ``--controller process:./my_controller``."""

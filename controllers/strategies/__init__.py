"""One file per controller; the file name is the controller's name."""

"""Methods that change only the speed, as filters of any driver: who is in the way, and what each allows."""

"""Methods that change the speed alone, as filters of any driver: who is in the way, and what each allows."""

"""What people met in their first hour with the program, and must not meet again."""

"""Pictures of curves, fields and any dimension."""

"""How scenes are drawn without a graphics card: solids, sight, paint, and one look for all."""

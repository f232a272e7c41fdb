"""A load on separate attachments turns until forces and moments balance (Sect. 2.2)."""
